"""Starting a program that ends with this one, and that nobody can reach over a network.

A command starts with one of these prefixes. ``python3 children.py command ...`` runs a command with
the loopback interface up, as it is down in a new network.
"""

import fcntl
import os
import socket
import struct
import subprocess
import sys

# However this process ends, and be it by SIGKILL, the kernel then ends the program.
ENDS_WITH_PARENT = ("setpriv", "--pdeathsig", "KILL")
PRIVATE_NETWORK = ("unshare", "--user", "--map-root-user", "--net")
SET_INTERFACE_FLAGS, UP_AND_RUNNING = 0x8914, 0x1 | 0x40


def in_private_network() -> tuple[str, ...]:
    """Prefix of a command that runs with a private loopback interface and no other network.

    Empty, with a warning, where the system allows no such network.
    """
    if subprocess.run([*PRIVATE_NETWORK, "true"], capture_output=True, check=False).returncode:
        print(
            "no private network namespace here: MPI listens on ports of all interfaces", flush=True
        )
        return ()
    return (*PRIVATE_NETWORK, *ENDS_WITH_PARENT, sys.executable, __file__)


if __name__ == "__main__":
    with socket.socket() as any_socket:
        flags = struct.pack("16sh14x", b"lo", UP_AND_RUNNING)
        fcntl.ioctl(any_socket, SET_INTERFACE_FLAGS, flags)
    os.execvp(sys.argv[1], sys.argv[1:])
