# SPDX-License-Identifier: Apache-2.0
"""Makes the connection to a daemon: a Unix socket, TCP, or TLS."""
from __future__ import annotations

import dataclasses
import errno
import ipaddress
import os
import pathlib
import socket
import ssl
import stat
import typing

from .errors import DisparityError

# This is longer than any use, and clocks and sockets can still hold it.
LONGEST_WAIT = 1e9

Path = typing.Union[str, "os.PathLike[str]"]


@dataclasses.dataclass
class ConnectOptions:
    """How a client and a daemon beyond this machine know each other. The files are read whenever a connection is made."""

    authority: Path | None = None  # who must have signed the daemon's certificate (PEM); None: the system's authorities
    certificate: Path | None = None  # this client's own, with its chain (PEM)
    key: Path | None = None  # of that certificate (PEM, not encrypted)
    server_name: str | None = None  # name or address in the daemon's certificate; None: HOST of the address
    token_file: Path | None = None  # with the token that the daemon asks for; not every user may read it
    token: str | None = None  # the token itself; goes before token_file


def connect(address: str, timeout: float, options: ConnectOptions | None = None) -> socket.socket:
    """Returns a connected socket. ValueError for an address of another form and for files that cannot be used,
    DisparityError when no process accepts, or the other end is not who it should be."""
    options = options or ConnectOptions()
    kind, _, rest = address.partition(":")
    if kind in ("tcp", "tls") and rest.startswith("//"):  # as a URL
        rest = rest[2:].rstrip("/")
    host, _, port = rest.rpartition(":")
    if not (kind == "unix" and rest) and not (kind in ("tcp", "tls") and host and port.isdigit()):
        raise ValueError(f'address "{address}": expected tcp:HOST:PORT, tls:HOST:PORT or unix:PATH')
    if kind != "unix" and not 1 <= int(port) <= 65535:
        raise ValueError(f"{address}: port: found {port}, allowed: 1 .. 65535")
    patience = min(timeout, LONGEST_WAIT)
    host = host.strip("[]")
    context = _context(options) if kind == "tls" else None
    try:
        if kind == "unix":
            return _connect_unix(rest, patience)
        connection = socket.create_connection((host, int(port)), patience)
    except (OSError, OverflowError) as error:
        if getattr(error, "errno", None) in (errno.EMFILE, errno.ENFILE):
            raise DisparityError(f"{address}: cannot connect: too many files are open: raise the limit (ulimit -n, or "
                                 "LimitNOFILE= of a service)") from None
        raise DisparityError(f"{address}: cannot connect: {error}: is disparityd running, with this address?") from None
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return connection if context is None else _begin_tls(connection, context, options.server_name or host, address)


def token_for(address: str, connection: socket.socket, options: ConnectOptions | None) -> str:
    """Returns the token to send over this connection; empty over a Unix socket, where the daemon needs none. ValueError
    for a file that cannot be used, and for a token that would be sent unencrypted to another machine."""
    if options is None or connection.family == socket.AF_UNIX:
        return ""
    token = options.token or (_read_token(options.token_file) if options.token_file else "")
    if token and not isinstance(connection, ssl.SSLSocket) and not _is_loopback(connection):
        raise ValueError(f"{address}: a token would be sent unencrypted, allowed: over tls:HOST:PORT, or to this machine")
    return token


def _connect_unix(path: str, timeout: float) -> socket.socket:
    connection = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    try:
        connection.settimeout(timeout)
        connection.connect(path)
    except BaseException:
        connection.close()
        raise
    return connection


def _context(options: ConnectOptions) -> ssl.SSLContext:
    if (options.certificate is None) != (options.key is None):
        raise ValueError("a client's certificate and its key go together: one of them is missing")
    for path in (options.authority, options.certificate, options.key):
        if path is not None and os.path.exists(path) and not os.path.isfile(path):  # a pipe would be waited for
            raise ValueError(f"{path}: is not a regular file, allowed: a file in PEM")
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    try:
        if options.authority is None:
            context.load_default_certs()
        else:
            context.load_verify_locations(options.authority)
    except OSError as error:
        raise ValueError(f"{options.authority}: the authority's certificate cannot be used: {error}") from None
    if options.certificate is not None:
        try:
            context.load_cert_chain(options.certificate, options.key, lambda: "")
        except OSError as error:
            raise ValueError(
                f"{options.certificate}, {options.key}: the certificate or its key cannot be used: {error}"
            ) from None
    return context


def _begin_tls(connection: socket.socket, context: ssl.SSLContext, name: str, address: str) -> ssl.SSLSocket:
    try:
        return context.wrap_socket(connection, server_hostname=name, suppress_ragged_eofs=True)
    except ssl.SSLCertVerificationError as error:
        connection.close()
        raise DisparityError(f"{address}: cannot connect: TLS: {error.verify_message}") from None
    except OSError as error:
        connection.close()
        hint = ""
        if isinstance(error, ssl.SSLError) and error.reason in ("WRONG_VERSION_NUMBER", "RECORD_LAYER_FAILURE"):
            hint = ": that port speaks no TLS: the daemon needs [socket] certificate and key, or is at tcp:HOST:PORT"
        raise DisparityError(f"{address}: cannot connect: TLS: {error}{hint}") from None


def _is_loopback(connection: socket.socket) -> bool:
    return ipaddress.ip_address(connection.getpeername()[0].partition("%")[0]).is_loopback


def _read_token(path: Path) -> str:
    """Returns, of the first line that is neither empty nor begins with #, the last word."""
    try:
        mode = os.stat(path).st_mode
        if not stat.S_ISREG(mode) and not stat.S_ISDIR(mode):  # a pipe would be waited for
            raise ValueError(f"{path}: the file with the token is not a regular file, allowed: a regular file")
        lines = pathlib.Path(path).read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise ValueError(f"{path}: the file with the token cannot be read: {error}") from None
    if mode & (stat.S_IROTH | stat.S_IWOTH):
        raise ValueError(f"{path}: every user may read the token; chmod o-rw {path}")
    for line in lines:
        if line.strip() and not line.startswith("#"):
            return line.split()[-1]
    raise ValueError(f"{path}: holds no token; write one into its first line")
