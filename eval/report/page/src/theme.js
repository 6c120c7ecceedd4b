import palette from '../palette.json' with { type: 'json' };

/** "light" or "dark", whatever the reader or the system prefers. */
export function preferredTheme() {
  return matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light';
}

export const OUTCOMES = palette.outcomes;

/** Why a point is called moving, by the numbers of Reason in mosbench/method.hpp. */
export const REASONS = palette.reasons;

/** [r, g, b] in 0..255 of "#rrggbb". */
export function rgb(hex) {
  return [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
}

export function outcomeColours(theme) {
  return palette.outcomes.map((outcome) => outcome[theme]);
}

export function surface(theme) {
  return {
    background: palette.background[theme],
    text: palette.text[theme],
    guide: palette.guide[theme],
  };
}

/** Cividis, whose order also holds for readers who do not see red or green apart. */
const CIVIDIS = ['#00224e', '#123570', '#3b496c', '#575d6d', '#707173', '#8a8678', '#a59c74', '#c3b369', '#e1cc55', '#fee838'].map(rgb);

/** Its dark end would vanish on a dark background. */
const FIRST = { light: 0, dark: 0.25 };

/** Colour of a fraction 0..1 on the scale. */
export function scaleColour(fraction, theme) {
  const within = FIRST[theme] + (1 - FIRST[theme]) * Math.min(Math.max(fraction, 0), 1);
  const place = within * (CIVIDIS.length - 1);
  const low = Math.min(Math.floor(place), CIVIDIS.length - 2);
  return CIVIDIS[low].map((c, i) => Math.round(c + (CIVIDIS[low + 1][i] - c) * (place - low)));
}

/** Runs beside each other, told apart with any colour vision, and again by their dashes. */
export const RUN_LINES = [
  { light: '#0072B2', dark: '#56B4E9', dash: [] },
  { light: '#E8590C', dark: '#FF6B2C', dash: [7, 3] },
  { light: '#00805E', dark: '#33C79A', dash: [2, 3] },
  { light: '#A8478A', dark: '#E79AC8', dash: [10, 3, 2, 3] },
  { light: '#8A6D00', dark: '#E8CE4A', dash: [5, 5] },
  { light: '#4A5360', dark: '#B7C0CC', dash: [12, 4] },
  { light: '#7A3B1D', dark: '#C98F6B', dash: [4, 2] },
  { light: '#5B2FB0', dark: '#A98BEF', dash: [1, 3] },
];

/** What uPlot draws the line of the i-th run with. */
export function runLine(i) {
  const { light, dark, dash } = RUN_LINES[i % RUN_LINES.length];
  return { colour: { light, dark }, dash: dash.length > 0 ? dash : undefined, width: 2 };
}

/** Paul Tol's muted scheme, and grey: told apart with any colour vision. */
export const SERIES = ['#332288', '#88CCEE', '#44AA99', '#117733', '#999933', '#DDCC77', '#CC6677', '#882255', '#AA4499', '#9AA3AF'];
