"""Runs one command and tells what it took: launch.py REPORT_FD LIMIT_S CPUS COMMAND...

A process counts the memory of the one it was forked from as its own peak; this program is
small, however large the one that measures has become. CPUS is how many processors the command is held
to, 0 for all. On REPORT_FD: wait status, wall and processor seconds, peak KiB, timed out or not.
"""

import os
import signal
import sys
import time

report, limit, cpus, *command = sys.argv[1:]
if int(cpus):
    os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[: int(cpus)])
os.set_inheritable(int(report), False)
expired = []
start = time.perf_counter()
child = os.posix_spawnp(command[0], command, os.environ)
signal.signal(signal.SIGALRM, lambda *_: (expired.append(True), os.kill(child, signal.SIGKILL)))
signal.setitimer(signal.ITIMER_REAL, float(limit))
_, status, usage = os.wait4(child, 0)
seconds = time.perf_counter() - start
line = f"{status} {seconds} {usage.ru_utime + usage.ru_stime} {usage.ru_maxrss} {len(expired)}"
os.write(int(report), line.encode())
