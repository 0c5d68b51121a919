from .schema.errors import SceneError as SceneError
from .schema.scene import HertzScene as HertzScene
from .schema.scene import RunScene as RunScene
from .schema.scene import WheelsetScene as WheelsetScene
from .schema.scene import load_scene as load_scene
from .schema.scene import parse_scene as parse_scene
