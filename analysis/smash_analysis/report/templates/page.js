"use strict";
(() => {
  const byId = (id) => document.getElementById(id);
  const behind = JSON.parse(byId("behind").textContent);
  const drawer = byId("drawer"), title = byId("drawer-title"), rows = byId("drawer-rows");
  let asked = null;

  /* The list of runs behind a cell. */
  const element = (name, text) => {
    const made = document.createElement(name);
    if (text !== undefined) made.textContent = text;
    return made;
  };

  const listing = (number) => {
    const [gridNumber, entries] = behind.cells[number];
    const [storeName, extra] = behind.grids[gridNumber];
    const store = behind.stores[storeName];
    const table = element("table");
    table.className = "data";
    const head = table.createTHead().insertRow();
    const names = [store.columns[0], ...extra, ...store.columns.slice(1)];
    names.forEach((name) => {
      const cell = head.appendChild(element("th", name));
      cell.scope = "col";
    });
    const body = table.createTBody();
    entries.forEach(([at, ...values]) => {
      const row = body.insertRow(), [first, ...rest] = store.rows[at];
      row.appendChild(element("th", first)).scope = "row";
      [...values, ...rest].forEach((value) => row.appendChild(element("td", value)));
    });
    return [table, entries.length, storeName.split("/").pop()];
  };

  const open = (button) => {
    if (asked) asked.removeAttribute("aria-current");
    asked = button;
    asked.setAttribute("aria-current", "true");
    const [table, count, kind] = listing(Number(button.dataset.cell));
    title.textContent = `${button.getAttribute("aria-label")} (${count} ${count === 1 ? kind.slice(0, -1) : kind})`;
    rows.replaceChildren(table);
    rows.scrollTo(0, 0);
    drawer.hidden = false;
    document.body.classList.add("asked");
    const box = button.getBoundingClientRect(), top = drawer.getBoundingClientRect().top;
    if (box.bottom > top) window.scrollBy(0, box.bottom - top + 24);
    drawer.focus({ preventScroll: true });
  };

  const close = () => {
    if (drawer.hidden) return;
    drawer.hidden = true;
    document.body.classList.remove("asked");
    if (!asked) return;
    asked.removeAttribute("aria-current");
    asked.focus({ preventScroll: true });
    asked = null;
  };

  byId("close").addEventListener("click", close);
  document.addEventListener("click", (event) => {
    const button = event.target.closest("[data-cell]");
    if (button) open(button);
  });
  document.addEventListener("keydown", (event) => {
    if (event.key !== "Escape") return;
    if (byId("menu").open) byId("menu").open = false;
    else close();
  });

  /* A grid is one stop for Tab; arrow keys move inside it. */
  const steps = { ArrowRight: [0, 1], ArrowLeft: [0, -1], ArrowDown: [1, 0], ArrowUp: [-1, 0] };
  const enter = (grid, button) => {
    grid.querySelectorAll("button[tabindex='0']").forEach((other) => (other.tabIndex = -1));
    button.tabIndex = 0;
  };
  const next = (button, [down, right]) => {
    let row = button.closest("tr"), at = button.closest("td").cellIndex + right;
    row = down === 0 ? row : row.parentElement.rows[row.sectionRowIndex + down];
    while (row && at > 0 && at < row.cells.length) {
      const found = row.cells[at].querySelector("button");
      if (found) return found;
      at += right;
      row = down === 0 ? row : row.parentElement.rows[row.sectionRowIndex + down];
    }
    return null;
  };
  document.querySelectorAll("table.grid").forEach((grid) => {
    const first = grid.querySelector("button");
    if (first) first.tabIndex = 0;
    grid.addEventListener("focusin", (event) => {
      if (event.target.dataset.cell) enter(grid, event.target);
    });
    grid.addEventListener("keydown", (event) => {
      if (!(event.key in steps) || !event.target.dataset.cell) return;
      event.preventDefault();
      const found = next(event.target, steps[event.key]);
      if (found) found.focus();
    });
  });

  /* Pressing a name in a legend brings its curve out. */
  document.querySelectorAll(".chart").forEach((chart) => {
    const buttons = [...chart.querySelectorAll(".legend button")];
    const show = () => {
      const chosen = new Set(buttons.filter((b) => b.getAttribute("aria-pressed") === "true").map((b) => b.dataset.name));
      chart.classList.toggle("focused", chosen.size > 0);
      chart.querySelectorAll("[data-curve]").forEach((curve) => {
        curve.classList.toggle("chosen", chosen.has(curve.dataset.curve));
      });
    };
    buttons.forEach((button) => {
      button.addEventListener("click", () => {
        button.setAttribute("aria-pressed", String(button.getAttribute("aria-pressed") !== "true"));
        show();
      });
    });
  });

  /* Light, dark, or as the system says. */
  const themes = ["auto", "light", "dark"], root = document.documentElement, theme = byId("theme");
  const say = () => (theme.textContent = `Theme: ${root.dataset.theme || "auto"}`);
  theme.addEventListener("click", () => {
    const chosen = themes[(themes.indexOf(root.dataset.theme || "auto") + 1) % themes.length];
    if (chosen === "auto") delete root.dataset.theme;
    else root.dataset.theme = chosen;
    try {
      if (chosen === "auto") localStorage.removeItem("report-theme");
      else localStorage.setItem("report-theme", chosen);
    } catch {}
    say();
  });
  say();

  /* Folded parts: shown where a link leads there, and on paper. */
  const unfold = () => {
    const target = location.hash && document.getElementById(decodeURIComponent(location.hash.slice(1)));
    if (target && target.tagName === "DETAILS") target.open = true;
  };
  window.addEventListener("hashchange", unfold);
  unfold();
  byId("menu").addEventListener("click", (event) => {
    if (event.target.tagName === "A") byId("menu").open = false;
  });
  window.addEventListener("beforeprint", () => document.querySelectorAll("details.block").forEach((part) => (part.open = true)));
})();
