"""A microscope camera: pixels, and what the printed "RMS error" of its calibration may mean."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from sher3_paper.tables import printed

Floats = NDArray[np.float64]
Reading = Literal["tip", "noise", "field"]
READINGS: tuple[Reading, ...] = ("noise", "field", "tip")
"""`noise`: the RMS error is made anew at every reading; `field`: it is a smooth distortion; `tip`: no camera."""


@dataclass(frozen=True)
class View:
    """A field of view.

    Attributes:
        width: of the square view [m].
        pixel: size of a pixel [m].
        rms: root mean square of the error along an image axis [m].
    """

    width: float
    pixel: float
    rms: float


def view(name: Literal["10mm", "2mm"]) -> View:
    """Return a view of the paper with its units corrected: both numbers in um, and the two views not swapped.

    The paper prints 0.8 um and 4.9 mm for the 10 mm view, 3.8 um and 18.4 mm for the 2 mm view; a sensor of some 2600
    pixels makes 3.8 um of 10 mm and 0.8 um of 2 mm.
    """
    other = {"10mm": "view_2mm", "2mm": "view_10mm"}[name]
    numbers = printed()["camera"][other]
    return View({"10mm": 10e-3, "2mm": 2e-3}[name], numbers["pixel"] * 1e-6, numbers["rms"] * 1e-6)


def _terms(u: Floats) -> Floats:
    """Return the polynomial terms (n, 10) up to the third degree at image places (n, 2) in [-1, 1]."""
    x, y = u[:, 0], u[:, 1]
    return np.column_stack([x**i * y**j for i in range(4) for j in range(4 - i)])


class Camera:
    """One camera in one set-up.

    The distortion is a random cubic polynomial without its affine part, which a calibration against a stage removes,
    scaled to the RMS of the view.
    """

    def __init__(self, view: View, reading: Reading, seed: int = 0) -> None:
        self.view, self.reading = view, reading
        self._rng = np.random.default_rng(seed)
        line = np.linspace(-1.0, 1.0, 21)
        places = np.array([(x, y) for x in line for y in line])
        terms, affine = _terms(places), np.column_stack((np.ones(len(places)), places))
        curved = terms - affine @ np.linalg.lstsq(affine, terms, rcond=None)[0]
        weights = self._rng.standard_normal((terms.shape[1], 2))
        size = np.sqrt(((curved @ weights) ** 2).mean(axis=0))
        self._weights = weights * view.rms / size
        self._affine = np.linalg.lstsq(affine, terms @ self._weights, rcond=None)[0]

    def distortion(self, places: Floats) -> Floats:
        """Return the error (n, 2) [m] of a fixed distortion at places (n, 2) [m] seen from the centre of the view."""
        u = places / (self.view.width / 2)
        return _terms(u) @ self._weights - np.column_stack((np.ones(len(u)), u)) @ self._affine

    def read(self, places: Floats) -> Floats:
        """Return what the camera reads (n, 2) [m] of places (n, 2) [m] in its plane, seen from the centre."""
        if self.reading == "tip":
            return places
        error = self.distortion(places)
        if self.reading == "noise":
            error = self.view.rms * self._rng.standard_normal(places.shape)
        return self.view.pixel * np.round((places + error) / self.view.pixel)
