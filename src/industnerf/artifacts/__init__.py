"""The files between stages: frozen dataclasses that check what they read and what they write."""
