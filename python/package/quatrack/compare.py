"""Our law and each package's own controller on that package's own plant, in one table: `python -m quatrack.compare`.

The function of the same name flies our own plant, and is `quatrack.compare`.
"""

if __name__ == "__main__":
    from quatrack.integrations._table import main

    main()
