#include "framework/history/schema.h"

const char *const bb_history_steps[BB_HISTORY_VERSION] = {
    /* 1 */
    "CREATE TABLE runs(id INTEGER PRIMARY KEY, date TEXT NOT NULL, revision TEXT NOT NULL,"
    " version TEXT, host TEXT NOT NULL, cpu TEXT NOT NULL, device TEXT NOT NULL,"
    " driver TEXT NOT NULL, opencl TEXT, embree TEXT, build_flags TEXT, kernels TEXT, seed TEXT,"
    " command TEXT, interrupted INTEGER NOT NULL DEFAULT 0);"
    "CREATE INDEX runs_revision ON runs(revision);"
    "CREATE TABLE cells(id INTEGER PRIMARY KEY, key TEXT NOT NULL UNIQUE);"
    "CREATE TABLE measurements(id INTEGER PRIMARY KEY,"
    " run INTEGER NOT NULL REFERENCES runs(id) ON DELETE CASCADE,"
    " cell INTEGER NOT NULL REFERENCES cells(id), trace INTEGER NOT NULL,"
    " reference INTEGER NOT NULL, status TEXT NOT NULL, scene_hash TEXT NOT NULL,"
    " rays_hash TEXT NOT NULL, samples TEXT, UNIQUE(run, cell));"
    "CREATE INDEX measurements_cell ON measurements(cell);"
    "CREATE TABLE figures(measurement INTEGER NOT NULL REFERENCES measurements(id)"
    " ON DELETE CASCADE, name TEXT NOT NULL, value REAL NOT NULL,"
    " PRIMARY KEY(measurement, name)) WITHOUT ROWID;",
    /* 2 */
    "ALTER TABLE runs ADD COLUMN shard TEXT NOT NULL DEFAULT '';"
    "CREATE TABLE floors(id INTEGER PRIMARY KEY, date TEXT NOT NULL, revision TEXT NOT NULL,"
    " host TEXT NOT NULL, cpu TEXT NOT NULL, device TEXT NOT NULL, driver TEXT NOT NULL,"
    " share REAL NOT NULL, cells INTEGER NOT NULL);",
    /* 3 */
    "ALTER TABLE runs ADD COLUMN device_type TEXT NOT NULL DEFAULT '';",
};
