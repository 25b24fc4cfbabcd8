"""The REST API and what the browser loads: `create_app(settings)` makes the web application."""
