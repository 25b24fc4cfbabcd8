"""The process that runs one method on one problem: `python -m gaitlab.benchmarks.mpcc_child MEMORY`."""

from gaitlab.benchmarks.mpcc_run import ProblemRun
from gaitlab.nlp.child_process import serve

if __name__ == "__main__":
    serve(ProblemRun)
