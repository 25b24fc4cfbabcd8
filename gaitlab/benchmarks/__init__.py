"""Published problems with their sources and optima."""
