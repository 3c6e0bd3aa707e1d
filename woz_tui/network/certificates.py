"""Who may join this user's sessions from another machine: a small certificate authority.

Its folder holds the authority, the certificate of the robot's computer, and which names were given
one. A name's certificate and key go to its owner in one file, the access file; they are not kept
here. Only certificates in the list count, so a name that is revoked is out at once.
"""

from __future__ import annotations

import ssl
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from woz_tui.network.listen_address import is_access_name
from woz_tui.system import files
from woz_tui.system.extras import install_command
from woz_tui.system.user_folders import config_folder

if TYPE_CHECKING:
    from cryptography.hazmat.primitives.asymmetric.ec import EllipticCurvePrivateKey
    from cryptography.x509 import Certificate

#: What the computer of the robot is called in its certificate, wherever it is reached.
SERVER_NAME = "woz-robot"
#: How long the authority and the robot's computer count, in days; a name's own: see `new`.
LONG_DAYS = 7300
#: Certificates count from here on, also for a robot whose clock is not set.
BEGINNING = datetime(2000, 1, 1, tzinfo=UTC)
#: Longest name, in characters.
LONGEST_NAME = 40
#: What cannot be done without the extra.
MISSING = f"certificates need the package `cryptography`: {install_command('network')}"


class AccessError(Exception):
    """Something about access cannot be done; the text says what, and what helps."""


class IssuedName(msgspec.Struct, frozen=True):
    """One certificate that was given out. Times as RFC 3339 in UTC; `serial` in hexadecimal."""

    name: str
    serial: str
    made: str
    expires: str
    revoked: str = ""


@dataclass(frozen=True, slots=True)
class AccessFile:
    """What its owner has: name, where the robot is (`host:port`, perhaps empty), certificates."""

    path: Path
    name: str
    address: str
    authority: str

    @classmethod
    def read(cls, path: Path) -> AccessFile:
        """Raises `AccessError` if it is none, `OSError` if it cannot be read."""
        with files.open_regular(path) as file:
            text = file.read(1 << 20).decode("utf-8", "replace")
        head = dict(
            line[2:].split(": ", 1)
            for line in text.splitlines()
            if line[:2] == "# " and ": " in line
        )
        _, begin, authority = text.rpartition("-----BEGIN CERTIFICATE-----")
        if "name" not in head or not begin or "PRIVATE KEY" not in text:
            raise AccessError(f"{path} is no access file; `woz access new NAME` writes one")
        return cls(path, head["name"], head.get("address", ""), begin + authority)

    def context(self) -> ssl.SSLContext:
        """For the client. Raises `AccessError` if the file is damaged."""
        made = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
        made.minimum_version = ssl.TLSVersion.TLSv1_3
        try:
            made.load_verify_locations(cadata=self.authority)
            made.load_cert_chain(self.path)
        except (ssl.SSLError, ValueError) as error:
            raise AccessError(f"{self.path} is damaged ({error}); copy it again") from None
        return made


def folder() -> Path:
    """`$XDG_CONFIG_HOME/woz/access`, else below `~/.config`."""
    return config_folder() / "woz" / "access"


class Authority:
    """The authority in one folder. Nothing is made before the first name is given."""

    def __init__(self, place: Path | None = None) -> None:
        self.place = folder() if place is None else place
        #: The list, and the file's state when it was read: whoever asks often costs no reading.
        self._names: tuple[IssuedName, ...] = ()
        self._read: tuple[int, ...] = ()

    # -- names -----------------------------------------------------------------------------------

    def names(self) -> tuple[IssuedName, ...]:
        """All that were ever given out. Raises `AccessError` if the list cannot be read."""
        try:
            file = (self.place / "names.json").stat()
            state = file.st_ino, file.st_mtime_ns, file.st_size
            if state != self._read:
                text = (self.place / "names.json").read_bytes()
                self._names = msgspec.json.decode(text, type=tuple[IssuedName, ...])
                self._read = state
            return self._names
        except FileNotFoundError:
            return ()
        except (OSError, msgspec.MsgspecError) as error:
            raise AccessError(
                f"{self.place / 'names.json'} cannot be read ({error}); nobody can join until it is"
                " repaired or removed (then make the access files anew)"
            ) from error

    def name_of(self, serial: str) -> str:
        """Whose certificate that is, unless it was revoked; then, and for strangers, nothing."""
        serial = f"{int(serial, 16):x}"
        living = (each.name for each in self.names() if each.serial == serial and not each.revoked)
        return next(living, "")

    def why_not(self, name: str, serial: str) -> str:
        """Why a certificate of this authority with this name is not in the list, or not any more.
        Only who has it is told.
        """
        serial = f"{int(serial, 16):x}"
        if any(each.serial == serial and each.name == name for each in self.names()):
            return f"the certificate of {name} was revoked"
        return (
            f"the robot does not know this certificate of {name}: `woz access new {name}` on the"
            " robot makes another access file"
        )

    def new(self, name: str, days: int, address: str, target: Path) -> IssuedName:
        """Give `name` a certificate for so many days and write its access file, mode 0600.

        Raises:
            AccessError: The name cannot be used, or the extra `network` is not installed.
            OSError: A file cannot be written; no certificate was given out then.
        """
        if not is_access_name(name):
            raise AccessError(f"{name!r} is no name: use letters (a to z), digits, - and _")
        if len(name) > LONGEST_NAME:
            raise AccessError(f"the name has more than {LONGEST_NAME} characters; choose a shorter")
        authority_key, authority = self._authority()
        key, certificate = _certificate(name, days, authority_key, authority)
        moment = datetime.now(UTC)
        issued = IssuedName(
            name=name,
            serial=f"{certificate.serial_number:x}",
            made=_text(moment),
            expires=_text(certificate.not_valid_after_utc),
        )
        head = f"# woz access file: keep it secret\n# name: {name}\n"
        head += f"# address: {address}\n" if address else ""
        parts = (head, _pem(key), _pem(certificate), _pem(authority))
        with files.replacing(target, "".join(parts), mode=0o600):
            self._write_names([*self.names(), issued])
        return issued

    def revoke(self, name: str) -> int:
        """Let nobody in by certificates of this name any more; how many there were.

        Raises `AccessError`, `OSError`.
        """
        now, names = _text(datetime.now(UTC)), self.names()
        hit = [each for each in names if each.name == name and not each.revoked]
        if hit:
            self._write_names(
                [
                    msgspec.structs.replace(each, revoked=now) if each in hit else each
                    for each in names
                ]
            )
        return len(hit)

    def context(self) -> ssl.SSLContext:
        """For the robot's computer: whoever comes in has a certificate of this authority.

        Raises `AccessError` if there is no authority yet, or its files are damaged.
        """
        if not (self.place / "server.pem").exists():
            raise AccessError(
                "nobody has access yet: make the first file with `woz access new NAME`"
            )
        made = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        made.minimum_version = ssl.TLSVersion.TLSv1_3
        # One without a certificate is told so in words; one with another authority's gets no
        # further than the handshake.
        made.verify_mode = ssl.CERT_OPTIONAL
        try:
            made.load_cert_chain(self.place / "server.pem")
            made.load_verify_locations(self.place / "authority.crt")
        except (ssl.SSLError, OSError) as error:
            raise AccessError(
                f"the certificates in {self.place} cannot be used ({error}); remove this folder and"
                " make the access files anew"
            ) from error
        return made

    # -- files -----------------------------------------------------------------------------------

    def _write_names(self, names: Sequence[IssuedName]) -> None:
        text = msgspec.json.format(msgspec.json.encode(names)).decode() + "\n"
        files.replace(self.place / "names.json", text, mode=0o600)

    def _authority(self) -> tuple[EllipticCurvePrivateKey, Certificate]:
        """The authority, made at the first use together with the robot's own certificate."""
        try:
            from cryptography import x509  # noqa: PLC0415 - only who gives access needs it
            from cryptography.hazmat.primitives.asymmetric import ec  # noqa: PLC0415
            from cryptography.hazmat.primitives.serialization import (  # noqa: PLC0415
                load_pem_private_key,
            )
        except ImportError:
            raise AccessError(MISSING) from None
        key_file, file = self.place / "authority.key", self.place / "authority.crt"
        if file.exists():
            key = load_pem_private_key(key_file.read_bytes(), None)
            assert isinstance(key, ec.EllipticCurvePrivateKey)
            return key, x509.load_pem_x509_certificate(file.read_bytes())
        self.place.mkdir(mode=0o700, parents=True, exist_ok=True)
        key, certificate = _certificate("woz access", LONG_DAYS)
        own = _certificate(SERVER_NAME, LONG_DAYS, key, certificate, server=True)
        files.replace(key_file, _pem(key), mode=0o600)
        files.replace(self.place / "server.pem", _pem(own[0]) + _pem(own[1]), mode=0o600)
        files.replace(file, _pem(certificate), mode=0o600)
        return key, certificate


def _certificate(
    name: str,
    days: int,
    by: EllipticCurvePrivateKey | None = None,
    authority: Certificate | None = None,
    *,
    server: bool = False,
) -> tuple[EllipticCurvePrivateKey, Certificate]:
    """A new key and its certificate, signed `by` the authority; without one, an authority's own."""
    from cryptography import x509  # noqa: PLC0415
    from cryptography.hazmat.primitives import hashes  # noqa: PLC0415
    from cryptography.hazmat.primitives.asymmetric import ec  # noqa: PLC0415
    from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID  # noqa: PLC0415

    key = ec.generate_private_key(ec.SECP256R1())
    subject = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, name)])
    builder = (
        x509.CertificateBuilder()
        .subject_name(subject)
        .issuer_name(subject if authority is None else authority.subject)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(BEGINNING)
        .not_valid_after(datetime.now(UTC) + timedelta(days=days))
        .add_extension(x509.BasicConstraints(ca=authority is None, path_length=None), critical=True)
    )
    if authority is not None:
        use = ExtendedKeyUsageOID.SERVER_AUTH if server else ExtendedKeyUsageOID.CLIENT_AUTH
        builder = builder.add_extension(x509.ExtendedKeyUsage([use]), critical=True)
    else:
        signing = {
            name: name in ("key_cert_sign", "crl_sign")
            for name in (
                *("digital_signature", "content_commitment", "key_encipherment"),
                *("data_encipherment", "key_agreement", "key_cert_sign", "crl_sign"),
                *("encipher_only", "decipher_only"),
            )
        }
        builder = builder.add_extension(x509.KeyUsage(**signing), critical=True)
    if server:
        builder = builder.add_extension(
            x509.SubjectAlternativeName([x509.DNSName(SERVER_NAME)]), critical=False
        )
    signer = by or key
    builder = builder.add_extension(
        x509.AuthorityKeyIdentifier.from_issuer_public_key(signer.public_key()), critical=False
    ).add_extension(x509.SubjectKeyIdentifier.from_public_key(key.public_key()), critical=False)
    return key, builder.sign(signer, hashes.SHA256())


def _pem(made: EllipticCurvePrivateKey | Certificate) -> str:
    from cryptography.hazmat.primitives.asymmetric import ec  # noqa: PLC0415
    from cryptography.hazmat.primitives.serialization import (  # noqa: PLC0415
        Encoding,
        NoEncryption,
        PrivateFormat,
    )

    if isinstance(made, ec.EllipticCurvePrivateKey):
        return made.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption()).decode()
    return made.public_bytes(Encoding.PEM).decode()


def _text(moment: datetime) -> str:
    return moment.strftime("%Y-%m-%dT%H:%M:%SZ")
