"""Light on a scene, and the settings of the camera that looks at it."""

from dataclasses import dataclass, replace

from mpap_cli.simulation.textures import Color


@dataclass(frozen=True, slots=True, kw_only=True)
class Light:
    """How a place is lit, and how the camera is set there.

    A light from one side (``azimuth_deg`` in the world, ``elevation_deg`` above the floor)
    and one from everywhere add up; ``color`` is the light's, ``balance`` what the camera
    multiplies red, green and blue with. ``drift`` is the deviation of the exposure over
    time, ``exposure_s`` how long a turning robot smears the image, ``noise`` the deviation
    of a pixel (of 255). ``haze_m``: at this distance half of the light is haze.
    """

    azimuth_deg: float
    elevation_deg: float
    direct: float
    ambient: float
    color: Color
    balance: Color
    gain: float
    gamma: float
    vignette: float
    drift: float
    exposure_s: float
    noise: float
    haze: Color
    haze_m: float
    jpeg_quality: int


_DAY = Light(
    azimuth_deg=35.0,
    elevation_deg=50.0,
    direct=0.55,
    ambient=0.55,
    color=(1.0, 1.0, 1.0),
    balance=(1.0, 1.0, 1.0),
    gain=1.0,
    gamma=2.2,
    vignette=0.25,
    drift=0.05,
    exposure_s=0.004,
    noise=2.0,
    haze=(0.70, 0.74, 0.80),
    haze_m=60.0,
    jpeg_quality=90,
)
_EVENING = Light(
    azimuth_deg=-110.0,
    elevation_deg=30.0,
    direct=0.30,
    ambient=0.32,
    color=(1.0, 0.82, 0.62),
    balance=(0.99, 1.20, 1.58),
    gain=1.75,
    gamma=2.0,
    vignette=0.35,
    drift=0.07,
    exposure_s=0.012,
    noise=3.5,
    haze=(0.50, 0.42, 0.40),
    haze_m=40.0,
    jpeg_quality=80,
)

LIGHTS: dict[str, Light] = {
    "day": _DAY,
    "evening": _EVENING,
    # the same evening to a camera that hardly balances its white
    "dusk": replace(_EVENING, balance=(0.96, 1.08, 1.32), gain=1.7),
}
