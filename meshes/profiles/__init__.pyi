from .library import load_profile as load_profile
from .named import named_profile as named_profile
from .profile import Profile as Profile
from .reader import read_profile as read_profile
