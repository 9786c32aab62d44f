# SPDX-License-Identifier: Apache-2.0
"""How the tests wait: they ask until it is so. No test sleeps for a time in which something should have
happened (tests/arch/sleep_check.py)."""
import time

from wire_client import WAIT_S


def eventually(ask, what, timeout=WAIT_S, every_s=0.02):
    """Asks until the answer is true, and returns it.

    After `timeout` seconds an AssertionError says what did not come; `what` may be called for that.
    """
    end = time.monotonic() + timeout
    while not (answer := ask()):
        if time.monotonic() > end:
            raise AssertionError(f"after {timeout:g} s: {what() if callable(what) else what}")
        time.sleep(every_s)
    return answer
