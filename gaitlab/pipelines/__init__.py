"""Pure computations: data in, result out, with progress."""
