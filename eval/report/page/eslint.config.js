const browser = ['atob', 'Blob', 'DecompressionStream', 'Response', 'URL', 'XMLSerializer', 'document', 'devicePixelRatio', 'fetch', 'location', 'matchMedia', 'navigator', 'performance', 'requestAnimationFrame', 'ResizeObserver', 'setInterval', 'clearInterval', 'setTimeout'];
const node = ['console', 'process', 'Buffer'];
const named = (names) => Object.fromEntries(names.map((name) => [name, 'readonly']));

const rules = {
  'constructor-super': 'error',
  'eqeqeq': 'error',
  'no-const-assign': 'error',
  'no-dupe-keys': 'error',
  'no-eval': 'error',
  'no-implied-eval': 'error',
  'no-restricted-properties': [
    'error',
    ...['innerHTML', 'outerHTML', 'insertAdjacentHTML', 'write', 'writeln'].map((property) => ({ property, message: 'strings must never become markup: use element()' })),
  ],
  'no-shadow': 'error',
  'no-undef': 'error',
  'no-unreachable': 'error',
  'no-unused-vars': ['error', { argsIgnorePattern: '^_' }],
  'no-var': 'error',
  'object-shorthand': 'error',
  'prefer-const': 'error',
  'max-lines': ['error', 200],
  'max-lines-per-function': ['error', 45],
  'complexity': ['error', 12],
};

export default [
  { ignores: ['node_modules/'] },
  { files: ['src/**/*.js'], languageOptions: { globals: named(browser) }, rules },
  { files: ['*.mjs', '*.js', 'test/**/*.mjs'], languageOptions: { globals: named([...node, ...browser]) }, rules: { ...rules, 'no-restricted-properties': 'off' } },
];
