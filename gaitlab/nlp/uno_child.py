"""The process that runs Uno: `python -m gaitlab.nlp.uno_child MEMORY`, spoken to by `uno.PreparedUno`."""

from gaitlab.nlp.child_process import serve
from gaitlab.nlp.uno_call import UnoCall

if __name__ == "__main__":
    serve(UnoCall)
