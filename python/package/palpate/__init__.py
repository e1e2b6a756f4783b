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
    LiveError,
    PalpateError,
    PlanError,
    RecognitionError,
    StudyError,
    SurfaceError,
)
from ._diff import FitDiff
from ._explore import Exploration, ExploreStep, Known, TouchPlanner, explore, next_touches
from ._fit import Fit, fit
from ._frontier import Frontier, FrontierPick, frontier
from ._live import LiveAnswer, LiveLoop, NextTouch, live
from ._live_answers import live_answers
from ._many import FitMany, fit_many, tiles
from ._mesh import SurfaceMesh, surface_mesh
from ._native import ParametricSurface, StreamShape, Surface, TouchStream, __version__
from ._parts import Parts, parts
from ._plan import AdaptivePlan, RepeatedHeights
from ._regressor import SurfaceRegressor
from ._shape import Certificate, Measure, Shape, Spread
from ._study import Study, StudyMeasure, merge, scene, scenes, simulate, study

__all__ = [
    "AdaptivePlan",
    "Certificate",
    "Exploration",
    "ExploreError",
    "ExploreStep",
    "Fit",
    "FitDiff",
    "FitError",
    "FitMany",
    "Frontier",
    "FrontierError",
    "FrontierPick",
    "Known",
    "LiveAnswer",
    "LiveError",
    "LiveLoop",
    "Measure",
    "NextTouch",
    "PalpateError",
    "ParametricSurface",
    "Parts",
    "PlanError",
    "RecognitionError",
    "RepeatedHeights",
    "Shape",
    "Spread",
    "StreamShape",
    "Study",
    "StudyError",
    "StudyMeasure",
    "Surface",
    "SurfaceError",
    "SurfaceMesh",
    "SurfaceRegressor",
    "TouchPlanner",
    "TouchStream",
    "__version__",
    "explore",
    "fit",
    "fit_many",
    "frontier",
    "live",
    "live_answers",
    "merge",
    "next_touches",
    "parts",
    "scene",
    "scenes",
    "simulate",
    "study",
    "surface_mesh",
    "tiles",
]
