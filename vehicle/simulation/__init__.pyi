from .checkpoint import Checkpoint as Checkpoint
from .history import History as History
from .limits import Limits as Limits
