"""Records: what runs, episodes and trials leave on disk, one schema for whoever writes or reads them.

`runs`, `episodes` and `trials` hold the types, `files` says which file holds which, `reading` and `writing` are the one
reader and the one writer. `docs/records.md` says what each field means and its unit.
"""
