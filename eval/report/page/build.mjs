// Bundles src/ into page.html, which the C++ build takes in. Run by scripts/build_report.sh.
import { createHash } from 'node:crypto';
import { readFileSync, writeFileSync } from 'node:fs';
import { build } from 'esbuild';

const folder = new URL('.', import.meta.url).pathname;
const bundle = async (entry, loader) => {
  const { outputFiles } = await build({
    entryPoints: [folder + entry],
    bundle: true,
    minify: true,
    write: false,
    format: 'iife',
    target: 'es2022',
    legalComments: 'none', // LICENCES below holds them in full
    loader,
  });
  // An element ends at its closing tag, wherever that stands.
  return outputFiles[0].text.trim().replaceAll('</script', '<\\/script');
};
const hash = (text) => `'sha256-${createHash('sha256').update(text).digest('base64')}'`;
const licence = (name) => {
  const { version } = JSON.parse(readFileSync(`${folder}node_modules/${name}/package.json`));
  return `${name} ${version}\n\n${readFileSync(`${folder}node_modules/${name}/LICENSE`, 'utf8').trim()}`;
};

const script = await bundle('src/main.js');
const style = await bundle('src/style.css');
const parts = {
  SCRIPT_HASH: hash(script),
  STYLE_HASH: hash(style),
  LICENCES: ['three', 'uplot'].map(licence).join('\n\n\n'),
  STYLE: style,
  SCRIPT: script,
};
const template = readFileSync(`${folder}src/page.html`, 'utf8');
const page = template.replace(/\b(SCRIPT_HASH|STYLE_HASH|LICENCES|STYLE|SCRIPT)\b/g, (name) => parts[name]);
if (process.argv.includes('--check')) {
  if (readFileSync(`${folder}page.html`, 'utf8') !== page) {
    console.error('page.html is not what src makes: run scripts/build_report.sh');
    process.exit(1);
  }
  console.log('page.html is what src makes');
} else {
  writeFileSync(`${folder}page.html`, page);
  console.log(`page.html: ${Math.round(page.length / 1000)} kB`);
}
