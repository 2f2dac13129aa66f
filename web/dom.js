// @ts-check
// The few helpers that every module of the page uses: elements, and numbers as people read them.

/**
 * The element with an id that index.html is known to have, as the class that the caller needs.
 * @template {typeof HTMLElement} C
 * @param {string} id
 * @param {C} [kind]
 * @returns {InstanceType<C>}
 */
export function byId(id, kind) {
  const found = document.getElementById(id);
  if (!(found instanceof (kind ?? HTMLElement))) throw new Error(`index.html has no #${id}`);
  return /** @type {InstanceType<C>} */ (found);
}

/**
 * A new element. Properties whose name has a dash become attributes (`data-…`, `aria-…`), all others are assigned.
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} tag
 * @param {Record<string, string | number | boolean | ((event: any) => void)>} [properties]
 * @param {(Node | string)[]} children
 * @returns {HTMLElementTagNameMap[K]}
 */
export function el(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name.includes("-") || name === "role" || name === "for") made.setAttribute(name, String(value));
    else Reflect.set(made, name, value);
  }
  made.append(...children);
  return made;
}

/** Styles that come with their script; settled once they hold. @param {string} href */
export function styles(href) {
  return new Promise((done, fail) => {
    document.head.append(el("link", { rel: "stylesheet", href, onload: done, onerror: fail }));
  });
}

/**
 * Sets text only where it differs: screen readers announce writes, and layout pays for them.
 * @param {HTMLElement} element
 * @param {string} text
 */
export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** @param {Element} element @param {string} name @param {string} value */
export function setAttr(element, name, value) {
  if (element.getAttribute(name) !== value) element.setAttribute(name, value);
}

const whole = new Intl.NumberFormat("en");

/** 1450 -> "1,450". @param {number} n */
export function full(n) {
  return whole.format(n);
}

/** 1450 -> "1,450", 23200 -> "23.2k", 1484800 -> "1.48M": at most five characters. @param {number} n */
export function short(n) {
  if (n < 10_000) return whole.format(n);
  for (const [unit, letter] of /** @type {[number, string][]} */ ([[1e3, "k"], [1e6, "M"], [1e9, "G"], [1e12, "T"]])) {
    const scaled = n / unit;
    if (scaled < 999.5) return Number(scaled.toPrecision(3)) + letter;
  }
  return n.toExponential(1);
}

/** 2202010 -> "2.2 MB". @param {number} n */
export function megabytes(n) {
  const mega = n / 1e6;
  if (mega >= 999.5) return `${(mega / 1e3).toPrecision(3)} GB`;
  return mega < 0.1 ? `${Math.round(n / 1e3)} kB` : `${mega < 99.95 ? mega.toFixed(1) : Math.round(mega)} MB`;
}

/** 0.4 -> "<1 ms", 12.3 -> "12 ms", 2300 -> "2.3 s". @param {number} ms */
export function duration(ms) {
  if (ms < 1) return "<1 ms";
  return ms < 1000 ? `${Math.round(ms)} ms` : `${(ms / 1000).toFixed(1)} s`;
}
