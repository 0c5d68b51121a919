from .contact_element import ContactElement as ContactElement
from .contact_element import ElementState as ElementState
from .element_solution import ElementSolution as ElementSolution
from .element_tangent import ElementTangent as ElementTangent
