import "@mantine/core/styles.css";
import "@mantine/dropzone/styles.css";
import "uplot/dist/uPlot.min.css";
import "./app/style.css";
import { createRoot } from "react-dom/client";
import { App } from "./app/App";

const root = document.getElementById("root");
if (root) createRoot(root).render(<App />);
