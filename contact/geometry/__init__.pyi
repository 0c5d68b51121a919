from .profile_pair import ProfilePair as ProfilePair
from .quadric_pair import QuadricPair as QuadricPair
from .rigid_surfaces import RigidQuadrics as RigidQuadrics
from .rigid_surfaces import RigidWheelRail as RigidWheelRail
from .surface_grid import ContactGrid as ContactGrid
