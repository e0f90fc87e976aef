# SPDX-License-Identifier: Apache-2.0
"""Finds the daemons of this machine by their names."""
from __future__ import annotations

import os
import pathlib
import re
import socket
import stat

from .connection import ConnectOptions
from .errors import DisparityError
from .shared_memory import SharedMemoryReader
from .socket_client import SocketClient

# Where a daemon of the name "default" listens when its configuration does not say otherwise.
_DEFAULT_TCP = "tcp:127.0.0.1:9876"
# The next one is written by everybody.
_TEMPORARY = "/tmp"
_NAME = "[A-Za-z0-9._-]{1,64}"
# A daemon whose heartbeat is older has died, s.
_OLDEST_HEARTBEAT = 3.0


def check_name(name: str) -> None:
    """Raises ValueError where no daemon can have this name."""
    if not re.fullmatch(_NAME, name):
        raise ValueError(f"name of a daemon: found '{name}', allowed: 1 to 64 characters of A-Z a-z 0-9 . _ -")


def open_memory_of(name: str, owner: str | int | None) -> SharedMemoryReader:
    """Maps the shared memory of a daemon that lives. DisparityError when there is none, it may not be read, or its
    daemon gives no sign of life."""
    reader = SharedMemoryReader(name, owner)
    if reader.heartbeat_age() > _OLDEST_HEARTBEAT:
        reader.close()
        raise DisparityError(f"shared memory /disparityd.{name}: its daemon has died")
    return reader


def _socket_folders() -> list[str]:
    """Returns where a daemon has its Unix socket by default: the first of these folders that it may write to. Only root
    and the service may create files in the first one."""
    runtime = os.environ.get("XDG_RUNTIME_DIR")
    return ["/run/disparityd", *([runtime] if runtime else []), _TEMPORARY]


def _socket_file(name: str, folder: str) -> str:
    own = f"-{os.getuid()}" if folder == _TEMPORARY else ""
    return "disparityd" + ("" if name == "default" else f"-{name}") + own + ".sock"


def _somebody_listens(path: pathlib.Path) -> bool:
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as attempt:
        attempt.setblocking(False)
        try:
            attempt.connect(str(path))
        except BlockingIOError:  # too many wait
            return True
        except OSError:
            return False
    return True


def _has_memory(name: str, owner: str | int | None) -> bool:
    try:
        open_memory_of(name, owner).close()
    except DisparityError:
        return False
    return True


def _running(owner: str | int | None) -> list[str]:
    """Returns the names of the daemons whose sockets somebody listens at, or whose shared memory can be read."""
    names = set()
    for folder in _socket_folders():
        before, behind = re.escape(_socket_file("*", folder)).split(r"\*")
        pattern = f"{re.escape(_socket_file('default', folder))}|{before}(?P<name>{_NAME}){behind}"
        for path in pathlib.Path(folder).glob("disparityd*.sock"):
            found = re.fullmatch(pattern, path.name)
            if found and stat.S_ISSOCK(path.lstat().st_mode) and _somebody_listens(path):
                names.add(found["name"] or "default")
    for path in pathlib.Path("/dev/shm").glob("disparityd.*"):
        name = path.name[len("disparityd.") :]
        if re.fullmatch(_NAME, name) and _has_memory(name, owner):
            names.add(name)
    return sorted(names)


def running_daemon(owner: str | int | None) -> str:
    """Returns the name of the daemon that runs on this machine: "default" where it runs, and where none does.
    DisparityError that names them where several others run."""
    names = _running(owner)
    if not names or "default" in names:
        return "default"
    if len(names) > 1:
        raise DisparityError(f"several daemons run on this machine: {', '.join(names)}; say which one")
    return names[0]


def _not_trusted(address: str, user: int, what: str) -> str:
    return (
        f"{address}: {what} user {user}, neither to this user nor to root, so it is left alone; if that daemon is meant, "
        f"say {address}"
    )


def connect_to(
    name: str, client_name: str, options: ConnectOptions | None, owner: str | int | None, timeout: float
) -> SocketClient:
    """Connects to the first socket of a daemon of this name that answers. A socket or a process of another user is left
    alone in a folder that other users may write to. timeout: for each socket. DisparityError tells which places were
    tried, which other daemons run, what to do."""
    trusted, refused, usable = (0, os.getuid()), [], []
    for folder in _socket_folders():
        path = os.path.join(folder, _socket_file(name, folder))
        of_the_system = folder == _socket_folders()[0]
        try:
            found = os.lstat(path)  # stat would follow a link of another user
        except OSError:
            continue
        if not stat.S_ISSOCK(found.st_mode):
            continue
        if of_the_system or found.st_uid in trusted:
            usable.append((f"unix:{path}", not of_the_system))
        else:
            refused.append(_not_trusted(f"unix:{path}", found.st_uid, "the socket belongs to"))
    if name == "default":  # a daemon of another name does not listen at the default port
        usable.append((_DEFAULT_TCP, False))
    failed = []
    for address, check_user in usable:
        try:
            client = SocketClient(address, client_name, timeout, options)
        except DisparityError as error:
            failed.append(str(error))
            continue
        user = client.server_user()
        if not check_user or user is None or user in trusted:
            return client
        client.close()
        refused.append(_not_trusted(address, user, "its process belongs to"))
    reasons = "; ".join(refused + failed) or f"there is no Unix socket of a daemon named {name}"
    others = [other for other in _running(owner) if other != name]
    if others:
        advice = f"daemons of other names run: {', '.join(others)}; say which one"
    else:
        option = "" if name == "default" else f" --name {name}"
        advice = f"start one with disparityd{option}, or say where it listens: unix:PATH, tcp:HOST:PORT or tls:HOST:PORT"
    raise DisparityError(f"no daemon answers: {reasons} ({advice})")
