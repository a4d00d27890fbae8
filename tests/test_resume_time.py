"""Seconds of an attempt count up to what it saved last; those after it are done again."""

import os

import pytest

from industnerf import resume_time


@pytest.fixture
def clock(monkeypatch):
    """`clock(t)`: it is now t."""
    return lambda now: monkeypatch.setattr(resume_time.time, "time", lambda: now)


def save_at(scratch, name, when):
    (scratch / name).write_text("half of it")
    os.utime(scratch / name, (when, when))


def test_the_first_attempt_has_none_before_it(tmp_path):
    assert resume_time.start_timer(tmp_path / "scratch") == 0.0


def test_what_saved_nothing_was_in_vain(tmp_path, clock):
    clock(1000.0)
    resume_time.start_timer(tmp_path)
    clock(1600.0)
    assert resume_time.start_timer(tmp_path) == 0.0


def test_attempts_add_up_to_what_each_saved_last(tmp_path, clock):
    clock(1000.0)
    resume_time.start_timer(tmp_path)
    save_at(tmp_path, "first.pt", 1020.0)
    save_at(tmp_path, "second.pt", 1050.0)
    clock(2000.0)
    assert resume_time.start_timer(tmp_path) == 50.0
    save_at(tmp_path, "second.pt", 2007.0)
    clock(3000.0)
    assert resume_time.start_timer(tmp_path) == 57.0
    clock(4000.0)  # the third saved nothing: what the files are of is counted already
    assert resume_time.start_timer(tmp_path) == 57.0


def test_a_torn_note_counts_nothing(tmp_path, clock):
    resume_time.start_timer(tmp_path)
    (tmp_path / resume_time.RECORD_FILE).write_text('{"before": 3')
    save_at(tmp_path, "first.pt", 1e12)
    assert resume_time.start_timer(tmp_path) == 0.0
