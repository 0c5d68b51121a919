from .components import Suspension as Suspension
from .wagon import Wagon as Wagon
