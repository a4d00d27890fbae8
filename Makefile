# Every target sets up .venv first: with uv where it is installed, else with venv and pip.
PYTHON ?= python3
export PATH := $(CURDIR)/.venv/bin:$(PATH)
INSTALLED := .venv/.installed

.PHONY: help demo test test-all smoke repro ui lint docs results clean

help:  ## this list
	@sed -n 's/^\([a-z-]*\):.*## /\1\t/p' $(MAKEFILE_LIST) | expand -t 10

demo: $(INSTALLED)  ## three parts at 512x512, ten methods, to runs/demo/reports/report.html
	@python -m pipeline.preset demo

test: $(INSTALLED)  ## the fast tests, on all cores
	@python -m pytest -n auto --dist loadfile -m "not slow and not slurm"

test-all: test  ## all tests: after the fast ones those that train or run whole pipelines
	@python -m pytest -n auto --dist loadfile -m "slow or slurm"

smoke: $(INSTALLED)  ## two parts at 64x64 through every stage
	@python -m pipeline.preset smoke

repro: $(INSTALLED)  ## the full study of params.yaml, resumable
	@python -m pipeline.check && dvc repro

ui: $(INSTALLED)  ## compare runs in the browser
	@database="$$(python -m industnerf.tracking)" && \
	  MLFLOW_SERVER_ENABLE_JOB_EXECUTION=false MLFLOW_DISABLE_TELEMETRY=true mlflow ui --workers 1 \
	  --backend-store-uri "$$database"

lint: $(INSTALLED)  ## style and import contracts
	@ruff check . && ruff format --check . && lint-imports

docs: .venv/.docs-installed  ## the documentation, to site/index.html
	@NO_MKDOCS_2_WARNING=1 mkdocs build

results: $(INSTALLED)  ## the finished study's numbers to results/study, README and docs/
	@python -m pipeline.publish

clean:  ## remove the environment, the store and every result that is not committed
	rm -rf .venv .store .slurm runs reports site mlruns mlflow.db mlflow.db.lock .dvc/cache .dvc/tmp
	rm -rf data/solids data/parts data/views data/split.json data/procedural data/weights \
	  data/truth data/states data/clouds data/scores

# uv does not read pip's configuration: hand its find-links on, so that both choose the same torch.
define install
if command -v uv >/dev/null; then \
  links="$${UV_FIND_LINKS:-$${PIP_FIND_LINKS:-$$($(PYTHON) -m pip config get global.find-links 2>/dev/null)}}"; \
  uv venv -q --allow-existing --python $(PYTHON) .venv && \
  UV_FIND_LINKS="$$links" uv pip install -q --python .venv/bin/python -c constraints.txt -e '.[$(1)]'; \
else \
  echo "uv is not installed: setting up with pip, which takes some minutes (pip install uv: seconds)"; \
  { [ -x .venv/bin/python ] || $(PYTHON) -m venv .venv; } && .venv/bin/python -m pip install -q -c constraints.txt -e '.[$(1)]'; \
fi
@touch $@
endef

$(INSTALLED): pyproject.toml constraints.txt
	@$(call install,test)

.venv/.docs-installed: $(INSTALLED)
	@$(call install,docs)
