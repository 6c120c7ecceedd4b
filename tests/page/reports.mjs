// Results and reports for the tests, made by the program under test.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';

const { MOSBENCH_PROGRAM, MOSBENCH_BINARY_DIR, MOSBENCH_SOURCE_DIR } = process.env;

export function mosbench(...args) {
  return execFileSync(MOSBENCH_PROGRAM, args, { encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe'] });
}

/** A fresh folder that goes when the process ends. */
export function freshFolder() {
  const folder = mkdtempSync(join(tmpdir(), 'mosbench_page_'));
  process.on('exit', () => rmSync(folder, { recursive: true, force: true }));
  return folder;
}

/** Where pictures are kept for whoever wants to look at them. */
export function artefacts() {
  const folder = join(MOSBENCH_BINARY_DIR, 'page_screenshots');
  mkdirSync(folder, { recursive: true });
  return folder;
}

export function resultOf(folder) {
  return JSON.parse(readFileSync(join(folder, 'result.json'), 'utf8'));
}

/** Dynamic scores of one scan of a run, from the file that --write scores writes. */
export function scoresOf(folder, stem) {
  const bytes = readFileSync(join(folder, 'scores', `${stem}.score`));
  return Array.from({ length: bytes.length / 4 }, (_, i) => bytes.readFloatLE(4 * i));
}

/** Simulates and segments part of a campus; two runs that differ in their delay, the first with scores. */
export function simulatedRuns(folder, scans = 24) {
  const dataset = join(folder, 'sim');
  mosbench('simulate', '--layout', 'sipailou', '--scene', 'campus', '--scans', String(scans), '--seed', '1', '--out', dataset);
  for (const [run, delay, ...flags] of [['online', 0, '--scores'], ['delayed', 4]]) {
    mosbench('run', dataset, '--set', `delay_scans=${delay}`, '--out', join(folder, run), ...flags);
  }
  return [join(folder, 'online'), join(folder, 'delayed')];
}

/** A third run of the same scans, with poses that odometry finds. */
export function runWithFoundPoses(folder) {
  mosbench('run', join(folder, 'sim'), '--odometry', 'simple', '--out', join(folder, 'found'));
  return join(folder, 'found');
}

/** The folder of KITTI's drive 0005 as the golden tests unpack it; null where it is not there. */
export function realSequence() {
  const shared = process.env.MOSBENCH_SHARED ?? resolve(MOSBENCH_SOURCE_DIR, '../shared');
  const unpack = join(shared, 'parity/unpack.sh');
  if (!existsSync(unpack)) return null;
  const folder = join(MOSBENCH_BINARY_DIR, 'parity');
  execFileSync('flock', [join(MOSBENCH_BINARY_DIR, 'parity.lock'), unpack, folder], { stdio: 'ignore' });
  return join(folder, 'sequences/kitti_0005');
}
