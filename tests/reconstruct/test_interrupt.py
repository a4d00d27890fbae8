"""Ctrl-C: the first is noted, the second ends."""

import os
import signal

import pytest

from industnerf.reconstruct.interrupt import Interrupt


def ctrl_c():
    os.kill(os.getpid(), signal.SIGINT)


def test_the_first_is_noted_and_the_second_ends():
    before = signal.getsignal(signal.SIGINT)
    with Interrupt() as stop:
        assert not stop.asked
        ctrl_c()
        assert stop.asked
        with pytest.raises(KeyboardInterrupt):
            ctrl_c()
    assert signal.getsignal(signal.SIGINT) is before


def test_the_usual_handler_is_back_after_an_error():
    before = signal.getsignal(signal.SIGINT)

    with pytest.raises(RuntimeError), Interrupt():
        raise RuntimeError
    assert signal.getsignal(signal.SIGINT) is before
