"""Long calls let others run, and Ctrl-C ends them."""

import os
import signal
import subprocess
import sys
import textwrap
import threading

import numpy as np
import pytest

import quatrack as q
from conftest import random_crafts

LONG = {"vehicle": "crazyflie-2.1", "course": "hover", "duration_s": 600.0}

# The arguments of each call, made before the signal may come: an interrupt inside another package's import or C code is
# that package's.
CALLS = {
    "fly": ("pass", f"q.fly({LONG!r})"),
    "fly with a law of one's own": (
        'c = q.Controller("quatrack", "crazyflie-2.1")',
        f"q.fly({LONG!r}, lambda given: c.step(given.state, given.reference).motor_forces)",
    ),
    "compare": ("pass", f"q.compare({LONG!r})"),
    "lyapunov": ("a, one = np.random.default_rng(1).normal(size=(160, 160)), np.eye(160)", "q.lyapunov(a, one)"),
}


@pytest.mark.skipif(os.name != "posix", reason="signals as POSIX has them")
@pytest.mark.parametrize("made, call", CALLS.values(), ids=CALLS.keys())
def test_ctrl_c_ends_it(made, call):
    # The process says when it begins: nothing is sent before. A shell's background job would ignore the signal.
    script = f"""
    import signal, numpy as np, quatrack as q
    signal.signal(signal.SIGINT, signal.default_int_handler)
    {made}
    try:
        print("begins", flush=True)
        {call}
        print("finished", flush=True)
    except KeyboardInterrupt:
        print("ended", flush=True)
    """
    process = subprocess.Popen([sys.executable, "-c", textwrap.dedent(script)], stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout.readline() == "begins\n"
        process.send_signal(signal.SIGINT)
        said, _ = process.communicate(timeout=30)
    finally:
        process.kill()
    assert said == "ended\n" and process.returncode == 0


def test_other_threads_run_during_a_flight():
    counted, over = [0], threading.Event()

    def count():
        while not over.is_set():
            counted[0] += 1
            over.wait(0.001)

    counter = threading.Thread(target=count)
    counter.start()
    before = counted[0]
    q.fly(LONG | {"duration_s": 300.0})
    during = counted[0] - before
    over.set()
    counter.join()
    # Some 150 ms of flight, in which the other thread sleeps for 1 ms at a time. Held, the lock would let none run.
    assert during > 1


def test_two_threads_do_not_step_one_controller_at_once():
    state, reference = random_crafts(20000)
    controller, errors = q.Controller("quatrack", "crazyflie-2.1"), []

    def steps():
        for _ in range(20):
            try:
                controller.step(state, reference)
            except RuntimeError as error:
                errors.append(str(error))

    threads = [threading.Thread(target=steps) for _ in range(2)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    # Either they took turns, or one was told.
    assert all("borrowed" in error for error in errors)
