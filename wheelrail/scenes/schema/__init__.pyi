from .errors import RunFailed as RunFailed
from .errors import SceneError as SceneError
from .scene import HertzScene as HertzScene
from .scene import RunScene as RunScene
from .scene import WheelsetScene as WheelsetScene
from .scene import load_scene as load_scene
from .scene import parse_scene as parse_scene
