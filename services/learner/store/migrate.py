"""Bring the tables of a store to the form of today, before anything is read or written."""

from importlib.resources import as_file, files

from alembic.operations import Operations
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import Connection


def migrate(connection: Connection) -> None:
    """Run the revisions that this store has not seen; all of them or none, in one transaction.

    Raises:
        CommandError: the store was written by a newer hl-dagger.
    """
    with as_file(files("services.learner.store") / "revisions") as folder:
        script = ScriptDirectory(folder, version_locations=[folder])
        context = MigrationContext.configure(connection)
        # Without an env.py, which would have to work at import; the steps are Alembic's own.
        with Operations.context(context):
            missing = script.iterate_revisions("head", context.get_current_heads() or "base")
            for revision in reversed([*missing]):
                revision.module.upgrade()
                context.stamp(script, revision.revision)
