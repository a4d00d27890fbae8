"""Bring README.md and docs/ up to date with params.yaml and results/.

python -m industnerf.report.docs
"""

from pathlib import Path

from industnerf.cli import exit_with_message
from industnerf.report.docs.documents import write_documents

if __name__ == "__main__":
    exit_with_message(lambda: print(f"wrote {', '.join(map(str, write_documents(Path())))}"))
