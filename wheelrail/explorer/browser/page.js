"use strict";
// Parts of the page that follow variables of the state by themselves: a move then renders them, not the whole page;
// and files that are dropped, the theme of the system, and keys.
window.wheelrail_page = (() => {
  const { h, markRaw } = window.Vue;

  // Component that renders values of the state whenever one of them changes.
  function following(names, props, emits, render) {
    return {
      inject: ["trame"],
      props,
      emits,
      data: () => ({ now: markRaw([]) }),
      created() {
        const own = names.map(name => name(this));
        this.stop = this.trame.state.watch(own, (...values) => { this.now = markRaw(values); });
      },
      beforeUnmount() { this.stop(); },
      render() { return render(this, ...this.now); },
    };
  }
  const variable = name => () => name;

  // Panels come as a text: the client of the state would look into every number otherwise.
  function parsed(self, text) {
    if (self.text !== text) [self.text, self.panels] = [text, text ? JSON.parse(text) : []];
    return self.panels;
  }

  const pictures = following(
    [self => self.name, self => self.stale, variable("reason"), variable("dark")],
    { name: String, stale: String, picks: Boolean },
    ["pick"],
    (self, panels, stale, reason, dark) => h("div", { style: "display: contents" }, parsed(self, panels).map((panel, index) =>
      h("div", { class: ["wr-view", `wr-${panel.view}`], key: `${panel.view} ${panel.side} ${index}` },
        h(window.Vue.resolveComponent("wr-drawing"), {
          drawing: panel.drawing,
          stale,
          dark,
          reason: index === 0 ? reason : "",
          ...(self.picks ? { onPick: at => self.$emit("pick", at) } : {}),
        })))));

  const table = following([variable("table")], {}, [], (_, shown) => {
    const row = (cells, tag) => h("tr", cells.map(cell => h(tag, cell)));
    return h("table", [row(shown?.head ?? [], "th"), ...(shown?.rows ?? []).map(cells => row(cells, "td"))]);
  });

  const status = following(["busy", "reason", "status", "seconds"].map(variable), {}, [], (_, busy, reason, said, seconds) =>
    h("span", { class: "wr-status text-body-2", "aria-live": "polite" },
      busy || reason || (said ? `${said}, ${(1e3 * seconds).toFixed(0)} ms` : "")));

  const slider = following(
    [self => self.name, self => self.variable || self.name],
    { name: String, label: String, unit: String, low: Number, high: Number, step: Number, text: Boolean,
      variable: String, value: String },
    [],
    (self, now, chosen) => {
      const { label, low: min, high: max, step } = self, set = value => self.trame.state.set(self.name, value);
      if (self.variable && chosen !== self.value) return h("div", { style: "display: none" });
      const bar = self.text ? null : h(window.Vue.resolveComponent("v-slider"), {
        modelValue: Number(now), min, max, step, density: "compact", hideDetails: true, "aria-label": label,
        "onUpdate:modelValue": set,
      });
      const field = h("input", {
        value: now, "aria-label": label, ...(self.text ? {} : { type: "number", min, max, step }),
        onChange: ({ target: { value } }) => set(self.text ? value : value && Number(value)),
      });
      return h("div", { class: "wr-control" }, [
        h("div", { class: "wr-label" }, `${label} [${self.unit}]`),
        h("div", { class: "wr-row" }, [bar, h("div", { class: self.text ? "wr-text" : "wr-number" }, [field])]),
      ]);
    });

  const drop = {
    props: { largest: { type: Number, default: 1e7 }, picks: Boolean },
    emits: ["file", "dark", "reset"],
    data: () => ({ over: false }),
    mounted() {
      this.$emit("dark", window.matchMedia("(prefers-color-scheme: dark)").matches);
      const typing = ({ tagName, type }) => /INPUT|TEXTAREA/.test(tagName) && type !== "range";
      this.listeners = {
        dragover: event => { event.preventDefault(); this.over = this.picks; },
        dragleave: event => { if (!event.relatedTarget) this.over = false; },
        drop: event => { event.preventDefault(); this.over = false; },
        keydown: event => {
          if (event.key === "r" && !typing(event.target) && !event.ctrlKey && !event.metaKey) this.$emit("reset");
        },
      };
      for (const [name, listener] of Object.entries(this.listeners)) window.addEventListener(name, listener);
    },
    beforeUnmount() {
      for (const [name, listener] of Object.entries(this.listeners)) window.removeEventListener(name, listener);
    },
    methods: {
      async read(kind, file) {
        this.over = false;
        if (!file) return;
        const content = file.size > this.largest ? null : await new Promise((done, failed) => {
          const reader = new FileReader();  // base 64: the connection does not bring an array of 2 MB
          reader.onload = () => done(reader.result.split(",")[1] ?? "");
          reader.onerror = () => failed(reader.error);
          reader.readAsDataURL(file);
        });
        this.$emit("file", { name: file.name, size: file.size, kind, content });
      },
    },
    render() {
      const kinds = this.picks ? ["wheel", "rail"] : [];
      const picks = kinds.map(kind => h("label", [`${kind} profile from a file`, h("input", {
        type: "file",
        class: `wr-file-${kind}`,
        onChange: ({ target }) => { this.read(kind, target.files[0]); target.value = ""; },
      })]));
      const targets = kinds.map(kind => h("div", {
        class: `wr-target-${kind}`,
        onDragover: event => event.preventDefault(),
        onDrop: event => { event.preventDefault(); this.read(kind, event.dataTransfer.files[0]); },
      }, `${kind} profile`));
      return h("div", [h("div", { class: "wr-pick" }, picks), this.over && h("div", { class: "wr-drop" }, targets)]);
    },
  };

  const components = { "wr-pictures": pictures, "wr-table": table, "wr-status": status, "wr-slider": slider, "wr-drop": drop };
  return { install: app => Object.entries(components).forEach(([name, own]) => app.component(name, own)) };
})();
