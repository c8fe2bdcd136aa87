"""Which sensors of a log are used, as ``--sensor`` asks for them."""

import logging

from mpap_cli.logs.topics import Roles, require_image, require_scan

LOGGER = logging.getLogger(__name__)
SENSORS = ("auto", "scan", "image", "both")
IMAGE_AND_SCANS_IF_ANY = "image and scans if any"
SCAN, IMAGE = frozenset({"scan"}), frozenset({"image", "odometry"})


def sensors_of(roles: Roles, name: str, asked: str) -> frozenset[str]:
    """Return what is to be replayed of a log.

    Parameters
    ----------
    roles : Roles
        Topics of the log.
    name : str
        Base name of the log.
    asked : str
        One of ``SENSORS``; auto takes what the log has. Commands that look at images may
        also ask for ``IMAGE_AND_SCANS_IF_ANY``.

    Returns
    -------
    frozenset of str
        Of scan, image and odometry, as :class:`ReplayOptions` takes them.

    Raises
    ------
    UsageError
        If a sensor is missing, or several topics could be meant.
    """
    if asked == "auto":
        return _what_there_is(roles, name)
    if asked in {"scan", "both"}:
        require_scan(roles, name)
    if asked != "scan":
        require_image(roles, name)
    if asked == IMAGE_AND_SCANS_IF_ANY:
        return IMAGE | (SCAN if roles.scan is not None else frozenset[str]())
    return {"scan": SCAN, "image": IMAGE, "both": SCAN | IMAGE}[asked]


def _what_there_is(roles: Roles, name: str) -> frozenset[str]:
    """Return the sensors of a log; of several cameras none, if there are scans."""
    if roles.scan is None and (roles.scan_candidates or roles.image is None):
        if roles.image_candidates and not roles.scan_candidates:
            require_image(roles, name)
        require_scan(roles, name)
    if roles.image is None and roles.image_candidates:
        LOGGER.warning("%s: %s; images are left out", name, roles.image_reason)
    scan = SCAN if roles.scan is not None else frozenset[str]()
    return scan | (IMAGE if roles.image is not None else frozenset[str]())
