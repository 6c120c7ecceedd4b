// The committed page is what its sources make, and they are clean.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { test } from 'node:test';

const cwd = new URL('../../eval/report/page/', import.meta.url).pathname;

for (const [name, ...command] of [
  ['the linter has nothing to say', 'node', 'node_modules/eslint/bin/eslint.js', '--max-warnings', '0', '.'],
  ['unit tests of the modules pass', 'npm', 'test', '--silent'],
  ['page.html is what the sources make', 'node', 'build.mjs', '--check'],
]) {
  test(name, () => {
    // Without the variable by which node's runner would take the inner tests for its own.
    const { NODE_TEST_CONTEXT: _, ...env } = process.env;
    const { status, stdout, stderr } = spawnSync(command[0], command.slice(1), { cwd, env, encoding: 'utf8' });
    assert.equal(status, 0, stdout + stderr);
  });
}
