// Bundles src/ into page.html, study.html and review.html, which the C++ build takes in. Run by scripts/build_report.sh.
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

const template = readFileSync(`${folder}src/page.html`, 'utf8');

/** The page that a script draws, with the licences of the libraries in it. */
async function pageOf(entry, libraries, { title = 'mosbench report', css = 'src/style.css', connect = '' } = {}) {
  const [script, style] = await Promise.all([bundle(entry), bundle(css)]);
  const parts = {
    SCRIPT_HASH: hash(script),
    STYLE_HASH: hash(style),
    LICENCES: libraries.map(licence).join('\n\n\n'),
    STYLE: style,
    SCRIPT: script,
    TITLE: title,
    CONNECT: connect,
  };
  return template.replace(/\b(SCRIPT_HASH|STYLE_HASH|LICENCES|STYLE|SCRIPT|TITLE|CONNECT)\b/g, (name) => parts[name]);
}

const pages = {
  'page.html': await pageOf('src/main.js', ['three', 'uplot']),
  'study.html': await pageOf('src/study.js', ['uplot']),
  // Asks the server it comes from, and no other one.
  'review.html': await pageOf('src/review.js', ['three'], { title: 'mosbench truth', css: 'src/review.css', connect: " connect-src 'self';" }),
};
for (const [name, page] of Object.entries(pages)) {
  if (!process.argv.includes('--check')) {
    writeFileSync(folder + name, page);
    console.log(`${name}: ${Math.round(page.length / 1000)} kB`);
  } else if (readFileSync(folder + name, 'utf8') !== page) {
    console.error(`${name} is not what src makes: run scripts/build_report.sh`);
    process.exitCode = 1;
  } else {
    console.log(`${name} is what src makes`);
  }
}
