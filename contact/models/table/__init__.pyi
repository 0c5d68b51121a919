from .force_table import ForceTable as ForceTable
from .model import TableContact as TableContact
