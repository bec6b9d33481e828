# SPDX-License-Identifier: MIT
"""20 volumes of 128^3 a second through smartvis serve on the loopback, one after the other.

What is asserted is the processor time of server and client together, so that other work on the machine does not
count: on an idle one the time that passes is less, because the two overlap. Both are printed.
"""

import subprocess
import sys
import time

import psutil
from conftest import layers
from test_serve import connect, image, read_message

VOLUMES = 40


def test_twenty_volumes_a_second() -> None:
    command = [sys.executable, "-P", "-m", "smartvis", "serve", "--port", "0", "--method", "mean"]
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    whole = image(layers((128, 128, 128)), spacing=(0.8, 0.8, 0.8)).pack()
    try:
        port = int(server.stdout.readline().split(":")[2].split(";")[0])
        with connect(port) as peer:

            def there_and_back() -> None:
                peer.sendall(whole)
                for _ in range(3):
                    read_message(peer, check=False)  # a peer of its own checks in test_serve.py

            there_and_back()  # activates
            process = psutil.Process(server.pid)
            before, start, own = process.cpu_times(), time.perf_counter(), time.process_time()
            for _ in range(VOLUMES):
                there_and_back()
            passed, own = time.perf_counter() - start, time.process_time() - own
            after = process.cpu_times()
    finally:
        server.terminate()
        server.communicate()
    busy = own + after.user + after.system - before.user - before.system
    print(f"serve: {VOLUMES / passed:.1f} volumes of 128^3 a second passed; {VOLUMES / busy:.1f} by processor time")
    assert VOLUMES / busy >= 20
