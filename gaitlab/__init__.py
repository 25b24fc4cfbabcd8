"""gaitlab: why does this patient walk this way?"""

__version__ = "0.1.0"
