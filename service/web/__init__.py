"""The street door: the web application and everything that knows HTTP."""
