"""CAD files in and out: readers, writers, units, ingest and export."""
