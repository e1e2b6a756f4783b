"""The shape of a curved surface from a few touches, and how far to trust it.

>>> import palpate
>>> contacts = palpate.simulate("paper-cylinder")
>>> found = palpate.fit(contacts)
>>> found.shape.class_name
'ridge'
"""

from ._errors import (
    ExploreError,
    FitError,
    FrontierError,
    PalpateError,
    PlanError,
    RecognitionError,
    StudyError,
    SurfaceError,
)
from ._explore import Exploration, ExploreStep, Known, TouchPlanner, explore, next_touches
from ._fit import Fit, fit
from ._frontier import Frontier, FrontierPick, frontier
from ._many import FitMany, fit_many, tiles
from ._native import ParametricSurface, StreamShape, Surface, TouchStream, __version__
from ._parts import Parts, parts
from ._regressor import SurfaceRegressor
from ._shape import Certificate, Measure, Shape, Spread
from ._study import Study, StudyMeasure, merge, scene, scenes, simulate, study

__all__ = [
    "Certificate",
    "Exploration",
    "ExploreError",
    "ExploreStep",
    "Fit",
    "FitError",
    "FitMany",
    "Frontier",
    "FrontierError",
    "FrontierPick",
    "Known",
    "Measure",
    "PalpateError",
    "ParametricSurface",
    "Parts",
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
    "SurfaceRegressor",
    "TouchPlanner",
    "TouchStream",
    "__version__",
    "explore",
    "fit",
    "fit_many",
    "frontier",
    "merge",
    "next_touches",
    "parts",
    "scene",
    "scenes",
    "simulate",
    "study",
    "tiles",
]
