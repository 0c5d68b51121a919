"""3D views and animations by PyVista."""
