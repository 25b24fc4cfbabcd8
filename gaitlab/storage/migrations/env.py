"""What Alembic runs: the steps inside one transaction on the connection that `storage.migrate` hands over."""

from alembic import context

from gaitlab.storage.models import Row

connection = context.config.attributes["connection"]
context.configure(connection=connection, target_metadata=Row.metadata, transactional_ddl=True)
with context.begin_transaction():
    context.run_migrations()
