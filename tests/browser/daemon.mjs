// A daemon with a data directory of its own on a free port of the loopback.
import { execFileSync, spawn } from 'node:child_process';
import { closeSync, openSync, readFileSync } from 'node:fs';
import { join } from 'node:path';

const pause = (ms) => new Promise((resolve) => { setTimeout(resolve, ms); });

const ENDED = new Set(['succeeded', 'failed', 'timed_out', 'cancelled']);

export class Daemon {
  // bin: where the programs are; work: a folder for what it writes.
  constructor(bin, work) {
    this.program = join(bin, 'pneulabd');
    this.solver = join(bin, 'pneulab-solve');
    this.work = work;
    this.data = join(work, 'data');
    this.process = null;
    this.url = '';
  }

  // A command of the program on the data directory, as `token add`; gives what it prints.
  command(...words) {
    return execFileSync(this.program, [...words, '--data', this.data], { encoding: 'utf8' }).trim();
  }

  // The shadow memory of a sanitizer does not fit under a limit of private memory.
  limit() {
    return /__(asan|tsan)_init/.test(readFileSync(this.solver, 'latin1')) ? '0' : '2048';
  }

  async start(options = []) {
    const errors = openSync(join(this.work, 'daemon.err'), 'a');
    this.process = spawn(this.program, ['--data', this.data, '--listen', '127.0.0.1:0',
      '--memory-limit', this.limit(), ...options], { stdio: ['ignore', 'pipe', errors] });
    closeSync(errors);
    this.ended = new Promise((resolve) => { this.process.once('exit', resolve); });
    let text = '';
    this.url = await new Promise((resolve, reject) => {
      this.process.stdout.on('data', (bytes) => {
        text += bytes;
        const line = /^listening on (\S+)$/m.exec(text);
        if (line) {
          resolve(line[1]);
        }
      });
      this.ended.then(() => reject(new Error(`the daemon did not start: ${this.log()}`)));
    });
  }

  async stop() {
    if (this.process) {
      this.process.kill('SIGTERM');
      await this.ended;
      this.process = null;
    }
  }

  log() {
    return readFileSync(join(this.work, 'daemon.err'), 'utf8');
  }

  // An answer of the API as { status, body }; the body is read as JSON when it is.
  async call(method, path, document, headers = {}) {
    const answer = await fetch(`${this.url}${path}`, {
      method,
      headers: document === undefined ? headers : { 'Content-Type': 'application/json', ...headers },
      body: document === undefined ? undefined : JSON.stringify(document),
    });
    const text = await answer.text();
    const isJson = /json/.test(answer.headers.get('content-type') || '');
    return { status: answer.status, body: isJson ? JSON.parse(text) : text };
  }

  // Submits a document and gives the job at its end; one that is refused is an error.
  async submit(document, seconds = 180) {
    const { status, body } = await this.call('POST', '/api/v1/jobs', document);
    if (status >= 300) {
      throw new Error(`the job is refused: ${JSON.stringify(body)}`);
    }
    return this.wait(body.id, seconds);
  }

  // Waits for the end of a job and gives it.
  async wait(id, seconds = 180) {
    const end = Date.now() + 1000 * seconds;
    for (;;) {
      const { body } = await this.call('GET', `/api/v1/jobs/${id}`);
      if (ENDED.has(body.state)) {
        return body;
      }
      if (Date.now() > end) {
        throw new Error(`job ${id} is still ${body.state} after ${seconds} s`);
      }
      await pause(100);
    }
  }
}

// A small finger that is solved in about a second, with whatever is to be different.
export function finger(changes = {}) {
  const { actuator = {}, ...rest } = changes;
  return {
    kind: 'response',
    name: 'a small finger',
    actuator: {
      family: 'pneunet', length: '38 mm', width: '20 mm', height: '15.6 mm',
      chambers: [{ config: 'B', count: 4 }], chamber_gap: '2 mm', side_wall: '2 mm', top_wall: '1.5 mm',
      bottom_layer: '4 mm', ...actuator,
    },
    material: 'elastic-50a',
    load: { pressure: { to: '20 kPa', steps: 4 } },
    accuracy: 'fast',
    ...rest,
  };
}
