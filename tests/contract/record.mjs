// Stands between the clients of a test and its daemon and keeps every byte that passes, as it is.
// usage: node record.mjs PORT_FILE RECORD
//
// PORT_FILE holds the port of the daemon and is read for every connection: a test may start its
// daemon again. Prints its own port. RECORD is a row of pieces, each a line "CONNECTION SIDE SIZE"
// and SIZE bytes; SIDE is > for what a client sent, < for what the daemon did.
import { openSync, readFileSync, writeSync } from "node:fs";
import { connect, createServer } from "node:net";

const [portFile, recordFile] = process.argv.slice(2);
const record = openSync(recordFile, "w");
let connections = 0;

function keep(number, side, bytes) {
  writeSync(record, `${number} ${side} ${bytes.length}\n`);
  writeSync(record, bytes);
}

const server = createServer({ allowHalfOpen: true, noDelay: true }, (client) => {
  const number = ++connections;
  const port = Number(readFileSync(portFile, "utf8"));
  const daemon = connect({ host: "127.0.0.1", port, allowHalfOpen: true, noDelay: true });
  const pass = (from, to, side) => {
    from.on("data", (bytes) => {
      keep(number, side, bytes);
      if (!to.write(bytes)) {
        from.pause();
        to.once("drain", () => from.resume());
      }
    });
    from.on("end", () => to.end());
    from.on("close", () => to.destroySoon());
  };
  pass(client, daemon, ">");
  pass(daemon, client, "<");
  client.on("error", () => daemon.destroy());
  daemon.on("error", () => client.resetAndDestroy());
});
server.listen(0, "127.0.0.1", () => console.log(server.address().port));
