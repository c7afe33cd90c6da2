"""Run by Alembic: applies the migrations on the connection that `upgrade` hands over."""

from alembic import context

from services.correction_api.store.tables import metadata

context.configure(
    connection=context.config.attributes["connection"],
    target_metadata=metadata,
    render_as_batch=True,
)
with context.begin_transaction():
    context.run_migrations()
