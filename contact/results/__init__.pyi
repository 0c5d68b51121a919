from .error_estimate import ErrorEstimate as ErrorEstimate
from .result import ContactResult as ContactResult
from .result import Fields as Fields
from .result import Patch as Patch
from .result import Statistics as Statistics
