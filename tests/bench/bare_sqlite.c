/* The least that a durable row costs with SQLite, to compare submissions with:
 *   bare_sqlite DATABASE DOCUMENT SECONDS
 * Inserts the text of the file DOCUMENT, one row a transaction, with the settings of the daemon
 * (write-ahead log, synchronous=FULL), and prints the transactions a second. */
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/bench/load_net.h"

int main(int argc, char **argv) {
  static char text[1 << 20];
  sqlite3 *db = NULL;
  sqlite3_stmt *insert = NULL;
  FILE *file = argc == 4 ? fopen(argv[2], "rb") : NULL;
  if (!file) {
    fprintf(stderr, "usage: bare_sqlite DATABASE DOCUMENT SECONDS\n");
    return 2;
  }
  int size = (int)fread(text, 1, sizeof text, file);
  fclose(file);
  if (sqlite3_open(argv[1], &db) != SQLITE_OK ||
      sqlite3_exec(db,
                   "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL;"
                   "CREATE TABLE row (id INTEGER PRIMARY KEY, document TEXT NOT NULL)",
                   NULL, NULL, NULL) != SQLITE_OK ||
      sqlite3_prepare_v2(db, "INSERT INTO row (document) VALUES (?)", -1, &insert, NULL) !=
          SQLITE_OK) {
    fprintf(stderr, "bare_sqlite: %s\n", sqlite3_errmsg(db));
    return 1;
  }
  double since = load_now_ms(), now = since, seconds = atof(argv[3]);
  long count = 0;
  int code = SQLITE_DONE;
  while (code == SQLITE_DONE && now - since < 1e3 * seconds) {
    sqlite3_bind_text(insert, 1, text, size, SQLITE_STATIC);
    code = sqlite3_step(insert);
    sqlite3_reset(insert);
    count++;
    now = load_now_ms();
  }
  printf("%.1f\n", 1e3 * (double)count / (now - since));
  sqlite3_finalize(insert);
  sqlite3_close(db);
  return code == SQLITE_DONE ? 0 : 1;
}
