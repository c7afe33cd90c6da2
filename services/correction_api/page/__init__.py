"""The web page: plain files, no build step; served by `routes/page.py`."""
