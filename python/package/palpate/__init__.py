"""The shape of a curved surface from a few touches, and how far to trust it.

>>> import palpate
>>> contacts = palpate.simulate("paper-cylinder")
>>> found = palpate.fit(contacts)
>>> found.shape.class_name
'ridge'
"""

from ._errors import FitError, PalpateError, PlanError, RecognitionError, StudyError, SurfaceError
from ._fit import Certificate, Fit, Measure, Shape, Spread, fit
from ._many import FitMany, fit_many, tiles
from ._native import ParametricSurface, StreamShape, Surface, TouchStream, __version__
from ._study import Study, StudyMeasure, merge, scene, scenes, simulate, study

__all__ = [
    "Certificate",
    "Fit",
    "FitError",
    "FitMany",
    "Measure",
    "PalpateError",
    "ParametricSurface",
    "PlanError",
    "RecognitionError",
    "Shape",
    "Spread",
    "StreamShape",
    "Study",
    "StudyError",
    "StudyMeasure",
    "Surface",
    "SurfaceError",
    "TouchStream",
    "__version__",
    "fit",
    "fit_many",
    "merge",
    "scene",
    "scenes",
    "simulate",
    "study",
    "tiles",
]
