"""Runs inside gdb (script/instructions-per-step): connects to a program in qemu's user mode, which waits at the socket
$SLALOM_SOCKET, and steps through what it does between its two SIGUSR1 signals. Writes "address count" for each
instruction that ran to $SLALOM_COUNTS."""
import collections
import os

import gdb

stopped = []
counts = collections.Counter()
gdb.execute("set pagination off")
gdb.execute("handle SIGUSR1 stop nopass", to_string=True)
gdb.events.stop.connect(lambda event: stopped.append(isinstance(event, gdb.SignalEvent)))
gdb.execute(f"target remote {os.environ['SLALOM_SOCKET']}", to_string=True)
stopped.clear()
gdb.execute("continue", to_string=True)
if not stopped[-1]:
    raise gdb.GdbError("the program did not stop before the batch")
stopped[-1] = False
while not stopped[-1]:
    counts[int(gdb.parse_and_eval("$pc"))] += 1
    stopped.clear()
    gdb.execute("stepi", to_string=True)
gdb.execute("kill", to_string=True)
with open(os.environ["SLALOM_COUNTS"], "w", encoding="utf-8") as file:
    for address, times in counts.items():
        file.write(f"{address:x} {times}\n")
