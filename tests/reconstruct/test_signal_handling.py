"""Ctrl-C: the first is noted, the second ends."""

import os
import signal

import pytest

from industnerf.reconstruct.display import GracefulInterrupt


def ctrl_c():
    os.kill(os.getpid(), signal.SIGINT)


def test_the_first_is_noted_and_the_second_ends():
    previous_handler = signal.getsignal(signal.SIGINT)
    with GracefulInterrupt() as interrupt:
        assert not interrupt.requested
        ctrl_c()
        assert interrupt.requested
        with pytest.raises(KeyboardInterrupt):
            ctrl_c()
    assert signal.getsignal(signal.SIGINT) is previous_handler


def test_the_usual_handler_is_back_after_an_error():
    previous_handler = signal.getsignal(signal.SIGINT)

    with pytest.raises(RuntimeError), GracefulInterrupt():
        raise RuntimeError
    assert signal.getsignal(signal.SIGINT) is previous_handler
