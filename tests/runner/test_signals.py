"""What is put off comes, and not before its time."""

import os
import signal
import subprocess
import threading
import time

import pytest

from industnerf.runner.signals import defer_signals


@pytest.fixture(autouse=True)
def interrupt_handler():
    """Python's own, which a job in the background of a shell does not have."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def test_a_signal_comes_when_the_block_is_over():
    done = []

    def work():
        with defer_signals():
            os.kill(os.getpid(), signal.SIGINT)
            done.append("all of it")

    with pytest.raises(KeyboardInterrupt):
        work()
    assert done == ["all of it"]


def test_so_does_one_that_another_thread_is_sent():
    """Linux gives a process's signal to any thread that does not block it."""
    ready, over = threading.Event(), threading.Event()
    other = threading.Thread(target=lambda: (ready.set(), over.wait()), daemon=True)
    other.start()
    ready.wait()
    done = []

    def work():
        with defer_signals():
            signal.pthread_kill(other.ident, signal.SIGINT)
            time.sleep(0.2)  # the other thread takes it, and tells this one, when it runs
            done.append("all of it")

    with pytest.raises(KeyboardInterrupt):
        work()
    over.set()
    other.join()
    assert done == ["all of it"]


def test_programs_that_are_started_meanwhile_wait_too():
    with defer_signals():
        program = subprocess.Popen(["sleep", "0.3"])
        program.terminate()
        assert program.wait() == 0


def test_a_terminal_that_goes_is_heard_of_afterwards():
    received = []
    before = signal.signal(signal.SIGHUP, lambda number, _: received.append(number))
    try:
        with defer_signals():
            os.kill(os.getpid(), signal.SIGHUP)
            assert received == []
        assert received == [signal.SIGHUP]
    finally:
        signal.signal(signal.SIGHUP, before)


def test_what_was_there_before_is_there_after():
    ending = signal.SIGINT, signal.SIGTERM, signal.SIGHUP
    before = {number: signal.getsignal(number) for number in ending}
    with pytest.raises(ValueError, match="within"), defer_signals():
        raise ValueError("within")
    assert {number: signal.getsignal(number) for number in before} == before
    assert signal.pthread_sigmask(signal.SIG_BLOCK, ()).isdisjoint(before)


def test_outside_the_main_thread_nothing_is_put_off():
    output = []

    def work():
        with defer_signals():
            output.append("there")

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert output == ["there"]
